"""From columns of numbers to recordings in SI: which one is time, what each is called, in which unit; shared by all."""
