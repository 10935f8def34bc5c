"""From named arrays with attributes, whatever file they come from, to tables."""
