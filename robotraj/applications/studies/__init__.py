"""Studies: many cases of one problem, planned once each, in a folder of Parquet files. Start with ``study.py``."""
