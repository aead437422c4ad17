"""Names of arguments and attributes: wrong ones are refused with those that may be meant."""
