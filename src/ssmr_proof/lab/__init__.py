"""Cases recorded in the lab's own formats, beside what a lab would know."""
