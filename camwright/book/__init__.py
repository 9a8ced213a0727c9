"""Recipe books: every combination of cut length, line speed and objective of a job, designed, validated and exported."""
