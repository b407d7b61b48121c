// Difference: a plate with a cylindrical hole.
float plate = abs(p.y) - 0.2;
float hole = length(p.xz) - 0.35;
return max(plate, -hole);
