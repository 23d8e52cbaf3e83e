// Plate of 100 x 40 mm with a slot notch, half as long and one element wide. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.0005         // element size ahead of the notch; twice that at the far end
  algorithm = 5      // 5: Delaunay; 6: rows (frontal)
  plug = 0           // 1: the notch is full of a body "plug"
];

L = 0.1; H = 0.04; N = 0.05; w = h / 2;

Point(1) = {0, 0, 0, 2 * h};
Point(2) = {L, 0, 0, h};
Point(3) = {L, H, 0, h};
Point(4) = {0, H, 0, 2 * h};
Point(5) = {0, H / 2 + w, 0, h};
Point(6) = {N, H / 2 + w, 0, h};
Point(7) = {N, H / 2 - w, 0, h};
Point(8) = {0, H / 2 - w, 0, h};
For k In {1:7}
  Line(k) = {k, k + 1};
EndFor
Line(8) = {8, 1};
Curve Loop(1) = {1:8};
Plane Surface(1) = {1};

Physical Surface("plate") = {1};
If (plug)
  Line(9) = {8, 5};
  Curve Loop(2) = {-9, -7, -6, -5};
  Plane Surface(2) = {2};
  Physical Surface("plug") = {2};
  Physical Curve("right") = {2};
EndIf
Physical Curve("bottom") = {1};
Physical Curve("top") = {3};

Mesh.Algorithm = algorithm;
Mesh.Optimize = 1;
