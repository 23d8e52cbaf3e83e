// Bar of 400 x 8 mm for a stress wave that comes back from its free end. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.001          // element size
];

L = 0.4; b = 0.004;
Point(1) = {0, 0, 0, h};
Point(2) = {L, 0, 0, h};
Point(3) = {L, b, 0, h};
Point(4) = {0, b, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};

Physical Surface("bar") = {1};
Physical Curve("struck") = {4};
Physical Curve("free") = {2};
Physical Point("axis") = {1};

Mesh.Algorithm = 6;
