"""What legs can do at most, estimated before a solve: reach, speed, push and load."""
