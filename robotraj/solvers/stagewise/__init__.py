"""Problems in stages: what a structure-exploiting solver takes.

An NLP of collocation couples neighbours only. Here it is rewritten over controls u_k and states x_k of stages k, with
linear dynamics x_{k+1} = F(u_k, x_k), path equalities and inequalities in each stage. ``reduction`` eliminates fixed
columns, states that linear defects determine and controls that a torque balance determines.
"""
