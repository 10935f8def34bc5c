"""The frozen set of sessions that every engine of the doctor is measured on, and what is made of its answers.

``frozen`` says which sessions and with which seeds, ``sources`` makes or reads one, ``session_process`` runs an engine
on it in a process of its own, ``judged`` says what the answer is worth, ``tables`` and ``side_by_side`` print it.
"""
