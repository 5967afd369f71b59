"""Somebody new, who has a recording and follows the pages of docs/formats to a report."""
