// Plate of L x H, its corner at the origin. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  L = 0.05
  H = 0.03
  h = 0.001          // element size
];

Point(1) = {0, 0, 0, h};
Point(2) = {L, 0, 0, h};
Point(3) = {L, H, 0, h};
Point(4) = {0, H, 0, h};
For k In {1:3}
  Line(k) = {k, k + 1};
EndFor
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};

Physical Surface("plate") = {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};

Mesh.Algorithm = 5;
Mesh.Optimize = 1;
