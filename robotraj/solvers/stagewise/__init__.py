"""Problems in stages, the input of a structure-exploiting solver.

An NLP of collocation couples only neighbouring intervals. Here it is written in controls u_k and states x_k of stages
k, with linear dynamics x_{k+1} = F(u_k, x_k), path equalities and inequalities in each stage. ``reduction`` eliminates
fixed columns, states defined by linear defects and controls defined by a torque balance.
"""
