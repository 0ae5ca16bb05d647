"""The values that a script gives to properties and parameters, and which of them are refused."""
