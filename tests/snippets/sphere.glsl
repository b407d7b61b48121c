// A sphere. Exact.
return length(p) - 0.7;
