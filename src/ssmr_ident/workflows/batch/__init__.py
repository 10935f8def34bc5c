"""``ident batch``: every session below a folder, each in a process that may fail, hang or be killed on its own.

Nothing is imported here, for each of those processes comes by and needs neither tables nor page.
"""
