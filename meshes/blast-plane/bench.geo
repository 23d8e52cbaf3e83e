// Bench 6 m high with a vertical blast hole behind its face, cut across: the hole is a slot of explosive, 76 mm wide, below
// 1.5 m of stemming. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  burden = 2.5,      // from the hole to the face
  h = 0.05,          // element size around hole and burden
  far = 1.0
];

d = 0.076; H = 6; top = 1.5; deep = 0.5; L = 12;
Point(1) = {-L, -L, 0, far};
Point(2) = {L, -L, 0, far};
Point(3) = {L, 0, 0, far};
Point(4) = {burden, 0, 0, h};
Point(5) = {burden, H, 0, h};
Point(6) = {-L, H, 0, far};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Point(11) = {-d / 2, -deep, 0};
Point(12) = {d / 2, -deep, 0};
Point(13) = {d / 2, H - top, 0};
Point(14) = {-d / 2, H - top, 0};
Line(11) = {11, 12};
Line(12) = {12, 13};
Line(13) = {13, 14};
Line(14) = {14, 11};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Curve Loop(2) = {11, 12, 13, 14};
Plane Surface(1) = {1, 2};

Physical Surface("rock") = {1};
Physical Curve("hole") = {11, 12, 13, 14};
Physical Curve("outer") = {1, 2, 6};
Physical Curve("face") = {4};
Physical Curve("bench") = {5};

Field[1] = Box;
Field[1].XMin = -1.2; Field[1].XMax = burden;
Field[1].YMin = -0.8; Field[1].YMax = H;
Field[1].VIn = h; Field[1].VOut = far;
Field[1].Thickness = 7;
Background Field = 1;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.Algorithm = 6;
