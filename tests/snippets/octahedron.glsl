// |x| + |y| + |z| <= s; a bound off the faces.
p = abs(p);
return (p.x + p.y + p.z - 0.9) * 0.57735027;
