"""The contract: every claim that a validation makes, one file each, with its judge and what it leaves out.

Start with ``contract.py``.
"""
