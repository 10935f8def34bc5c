"""What each verb does, from files to results: a file per verb, or a folder whose run.py is the verb."""
