"""How often each kind of probe was tried, how often the promise held, and what was lost."""
