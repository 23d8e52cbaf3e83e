// Double-notched beam for four-point bending: 800 x 200 mm, notches 40 mm deep at x = 0, top and bottom. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.006          // element size where cracks may run
  far = 0.03         // element size at the ends
];

D = 0.2; N = 0.04; w = 0.0025;
z = 0.14;            // half width of the fine part

Point(1) = {-0.4, 0, 0, far};
Point(2) = {-z, 0, 0, h};
Point(3) = {-0.08, 0, 0, h};
Point(4) = {-w, 0, 0, h};
Point(5) = {-w, N, 0, h};
Point(6) = {w, N, 0, h};
Point(7) = {w, 0, 0, h};
Point(8) = {z, 0, 0, h};
Point(9) = {0.4, 0, 0, far};
Point(10) = {0.4, D, 0, far};
Point(11) = {z, D, 0, h};
Point(12) = {0.08, D, 0, h};
Point(13) = {w, D, 0, h};
Point(14) = {w, D - N, 0, h};
Point(15) = {-w, D - N, 0, h};
Point(16) = {-w, D, 0, h};
Point(17) = {-z, D, 0, h};
Point(18) = {-0.4, D, 0, far};
For k In {1:17}
  Line(k) = {k, k + 1};
EndFor
Line(18) = {18, 1};
Curve Loop(1) = {1:18};
Plane Surface(1) = {1};

Physical Surface("beam") = {1};
Physical Point("support_inner") = {3};
Physical Point("support_outer") = {9};
Physical Point("load_inner") = {12};
Physical Point("load_outer") = {18};
Physical Point("bottom_left") = {4};
Physical Point("bottom_right") = {7};
Physical Point("top_left") = {16};
Physical Point("top_right") = {13};

Field[1] = Box;
Field[1].VIn = h; Field[1].VOut = far;
Field[1].XMin = -z; Field[1].XMax = z; Field[1].YMin = 0; Field[1].YMax = D; Field[1].Thickness = 0.15;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 5;
Mesh.Optimize = 1;
