"""Elements of XML, with file and line, and the numbers in them."""
