"""What a job is asked: the design, comparisons, lengths, envelopes, identification. Numbers, no words."""
