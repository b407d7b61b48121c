// A loop that never turns, and one that turns once.
float d = length(p) - 0.5;
for (int i = 5; i < 5; ++i) d -= 1.0;
for (int i = 0; i < 1; ++i) d += 0.1;
return d;
