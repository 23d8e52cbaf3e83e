// Half of a disc of rock around a borehole of radius 0.1 m, with a line from its wall on along which it may break. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.004,         // element size at the hole and along the line
  reach = 0.8,       // end of the line
  algorithm = 6,
  seed = 1
];

a = 0.1; R = 4;
Point(1) = {0, 0, 0};
Point(2) = {0, -a, 0};
Point(3) = {a, 0, 0};
Point(4) = {0, a, 0};
Point(5) = {reach, 0, 0};
Point(6) = {R, 0, 0};
Point(7) = {0, -R, 0};
Point(8) = {0, R, 0};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Line(3) = {3, 5};
Line(4) = {5, 6};
Circle(5) = {7, 1, 6};
Circle(6) = {6, 1, 8};
Line(7) = {7, 2};
Line(8) = {4, 8};
Curve Loop(1) = {5, -4, -3, -1, -7};
Curve Loop(2) = {-2, 3, 4, 6, -8};
Plane Surface(1) = {1};
Plane Surface(2) = {2};

Physical Surface("rock") = {1, 2};
Physical Curve("wall") = {1, 2};
Physical Curve("line") = {3};
Physical Curve("side") = {7, 8};
Physical Curve("outer") = {5, 6};
Physical Point("far") = {6};

// Size: h at the hole and along the line, growing with the distance from both.
Field[1] = Distance;
Field[1].CurvesList = {1, 2, 3};
Field[1].Sampling = 400;
Field[2] = MathEval;
Field[2].F = Sprintf("%g + 0.25*F1", h);
Background Field = 2;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.Algorithm = algorithm;
Mesh.RandomSeed = seed;
