// Beam of 2 x 0.2 m for three-point bending with a slot notch, half the depth and one element wide. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.01           // element size around the ligament
  far = 0.04         // element size at the ends
];

L = 1; D = 0.2; N = 0.1; w = h / 2; z = 0.06;

Point(1) = {-L, 0, 0, far};
Point(2) = {-z, 0, 0, h};
Point(3) = {-w, 0, 0, h};
Point(4) = {-w, N, 0, h};
Point(5) = {w, N, 0, h};
Point(6) = {w, 0, 0, h};
Point(7) = {z, 0, 0, h};
Point(8) = {L, 0, 0, far};
Point(9) = {L, D, 0, far};
Point(10) = {z, D, 0, h};
Point(11) = {0, D, 0, h};
Point(12) = {-z, D, 0, h};
Point(13) = {-L, D, 0, far};
For k In {1:12}
  Line(k) = {k, k + 1};
EndFor
Line(13) = {13, 1};
Curve Loop(1) = {1:13};
Plane Surface(1) = {1};

Physical Surface("beam") = {1};
Physical Point("left") = {1};
Physical Point("right") = {8};
Physical Point("load") = {11};
Physical Point("mouth_left") = {3};
Physical Point("mouth_right") = {6};

Field[1] = Box;
Field[1].VIn = h; Field[1].VOut = far;
Field[1].XMin = -z; Field[1].XMax = z; Field[1].YMin = 0; Field[1].YMax = D; Field[1].Thickness = 0.3;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 5;
Mesh.Optimize = 1;
