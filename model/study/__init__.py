"""Many runs for one question: what varies, running, the table; what matters, how fast, what is best, what fits."""
