// Square of rock with a hole in its middle, refined in a vertical band in which cracks run. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  a = 0.1,           // radius of the hole
  L = 30,            // half the side of the square
  h = 0.02,          // element size at the hole
  band = 0.06,       // in the band
  half = 1.0,        // half width of the band
  reach = 12,        // half height of the band
  far = 2.0          // at the outer boundary
];

Point(1) = {0, 0, 0};
Point(2) = {a, 0, 0};
Point(3) = {0, a, 0};
Point(4) = {-a, 0, 0};
Point(5) = {0, -a, 0};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {4, 1, 5};
Circle(4) = {5, 1, 2};
Point(6) = {-L, -L, 0};
Point(7) = {L, -L, 0};
Point(8) = {L, L, 0};
Point(9) = {-L, L, 0};
Line(5) = {6, 7};
Line(6) = {7, 8};
Line(7) = {8, 9};
Line(8) = {9, 6};
Curve Loop(1) = {5, 6, 7, 8};
Curve Loop(2) = {1, 2, 3, 4};
Plane Surface(1) = {1, 2};

Physical Surface("rock") = {1};
Physical Curve("hole") = {1, 2, 3, 4};
Physical Curve("outer") = {5, 6, 7, 8};
Physical Point("side") = {2};
Physical Point("crown") = {3};

// Size: h at the hole, growing to that of the band within it, and to the far one outside.
Field[1] = Distance;
Field[1].CurvesList = {1, 2, 3, 4};
Field[1].Sampling = 100;
Field[2] = MathEval;
Field[2].F = Sprintf("%g + 0.15*F1", h);
Field[3] = Box;
Field[3].XMin = -half; Field[3].XMax = half;
Field[3].YMin = -reach; Field[3].YMax = reach;
Field[3].VIn = band; Field[3].VOut = far;
Field[3].Thickness = 8;
Field[4] = Min;
Field[4].FieldsList = {2, 3};
Background Field = 4;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.Algorithm = 6;
