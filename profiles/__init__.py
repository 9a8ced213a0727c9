"""What a cam is: words, laws, machines, cam tables; needs nothing but numpy and scipy."""
