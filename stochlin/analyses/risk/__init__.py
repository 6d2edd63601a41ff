"""How often in a year buildings pound, and the gap with which they pound no more often than is asked."""
