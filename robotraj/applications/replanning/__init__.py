"""Plans in a control loop: one problem, solved again and again from measured states."""
