"""The frozen set of sessions that every engine of the doctor is measured on, and what is made of its answers.

``frozen`` says which sessions and with which seeds, ``opened`` makes or reads one, ``session_process`` runs an engine
on it in a process of its own, ``tables`` and ``side_by_side`` print what came out.
"""
