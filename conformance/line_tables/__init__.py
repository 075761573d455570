"""Tables of supports and droppers: lines from spreadsheets and back."""
