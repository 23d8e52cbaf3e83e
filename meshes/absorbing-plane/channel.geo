// Channel along x whose far end is cut at an angle: a plane wave that runs along it meets the end obliquely. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  angle = 30,        // between the channel and the normal of its end [deg]
  W = 0.12,          // width
  L = 0.04,          // length of the shorter side
  h = 0.001          // element size
];

run = W * Tan(angle * Pi / 180);
Point(1) = {0, 0, 0, h};
Point(2) = {L, 0, 0, h};
Point(3) = {L + run, W, 0, h};
Point(4) = {0, W, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};

Physical Surface("rock") = {1};
Physical Curve("source") = {4};
Physical Curve("sides") = {1, 3};
Physical Curve("end") = {2};

Mesh.Algorithm = 5;
