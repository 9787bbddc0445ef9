"""The gate before the page's and Foxglove's servers: who may connect is decided here."""
