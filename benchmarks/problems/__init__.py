"""Problems with trusted optima."""
