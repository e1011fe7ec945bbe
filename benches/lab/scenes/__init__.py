"""The lab's scenes, each in every size; and scans from the corpus of other people's files."""
