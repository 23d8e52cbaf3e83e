// Plane beam 1 x 0.1 m along x, centred on y = 0, in squares cut by alternating diagonals. Lengths in metres.
SetFactory("OpenCASCADE");

DefineConstant[
  depth = 4          // squares through the depth
];

Rectangle(1) = {0, -0.05, 0, 1, 0.1};
Transfinite Curve{1, 3} = 10*depth + 1;
Transfinite Curve{2, 4} = depth + 1;
Transfinite Surface{1} Alternate;

Physical Surface("beam") = {1};
Physical Curve("clamp") = {4};
Physical Curve("tip") = {2};
