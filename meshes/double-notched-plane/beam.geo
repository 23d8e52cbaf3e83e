// Double-notched beam for four-point bending: 800 x 200 mm, notches 40 mm deep at x = 0, top and bottom. Lengths in metres.
// The left half is the right one after a half turn, and so is its mesh: neither crack is favoured.
SetFactory("Built-in");

DefineConstant[
  h = 0.006          // element size where cracks may run
  far = 0.03         // element size at the ends
];

D = 0.2; N = 0.04; w = 0.0025;
z = 0.14;            // half width of the fine part

Point(1) = {0, N, 0, h};
Point(2) = {w, N, 0, h};
Point(3) = {w, 0, 0, h};
Point(4) = {z, 0, 0, h};
Point(5) = {0.4, 0, 0, far};
Point(6) = {0.4, D, 0, far};
Point(7) = {z, D, 0, h};
Point(8) = {0.08, D, 0, h};
Point(9) = {w, D, 0, h};
Point(10) = {w, D - N, 0, h};
Point(11) = {0, D - N, 0, h};
Point(12) = {-w, D - N, 0, h};
Point(13) = {-w, D, 0, h};
Point(14) = {-z, D, 0, h};
Point(15) = {-0.4, D, 0, far};
Point(16) = {-0.4, 0, 0, far};
Point(17) = {-z, 0, 0, h};
Point(18) = {-0.08, 0, 0, h};
Point(19) = {-w, 0, 0, h};
Point(20) = {-w, N, 0, h};
For k In {1:19}
  Line(k) = {k, k + 1};
EndFor
Line(20) = {20, 1};
Line(21) = {11, 1};
Transfinite Curve {21} = Round((D - 2 * N) / h) + 1;
Curve Loop(1) = {1:10, 21};
Curve Loop(2) = {11:20, -21};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Periodic Surface {2} = {1} Rotate {{0, 0, 1}, {0, D / 2, 0}, Pi};

Physical Surface("beam") = {1, 2};
Physical Point("support_inner") = {18};
Physical Point("support_outer") = {5};
Physical Point("load_inner") = {8};
Physical Point("load_outer") = {15};
Physical Point("bottom_left") = {19};
Physical Point("bottom_right") = {3};
Physical Point("top_left") = {13};
Physical Point("top_right") = {9};

Field[1] = Box;
Field[1].VIn = h; Field[1].VOut = far;
Field[1].XMin = -z; Field[1].XMax = z; Field[1].YMin = 0; Field[1].YMax = D; Field[1].Thickness = 0.15;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 5;
Mesh.Optimize = 1;
