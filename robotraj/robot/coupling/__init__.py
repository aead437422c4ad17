"""Joints that follow others: ``<mimic>`` tags, the model whose followers move with their leaders, and its dynamics."""
