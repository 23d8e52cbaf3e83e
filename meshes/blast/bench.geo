// Bench 6 m high with a row of vertical blast holes of 76 mm behind its face: one hole and the rock half-way to its neighbours,
// between two planes of symmetry. The charge ends below 1.5 m of stemming, which is rock here. Lengths in metres; z is up.
SetFactory("OpenCASCADE");

DefineConstant[
  burden = 2.5,      // from the hole to the face
  spacing = 3,       // from hole to hole
  wall = 0.03,       // element size at the hole
  h = 0.3,           // in the burden
  far = 1.5
];

d = 0.076; H = 6; top = 1.5; deep = 0.5; L = 10;
Point(1) = {-L, -spacing / 2, -L};
Point(2) = {L, -spacing / 2, -L};
Point(3) = {L, -spacing / 2, 0};
Point(4) = {burden, -spacing / 2, 0};
Point(5) = {burden, -spacing / 2, H};
Point(6) = {-L, -spacing / 2, H};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};
rock[] = Extrude {0, spacing, 0} { Surface{1}; };
Cylinder(100) = {0, 0, -deep, 0, 0, H - top + deep, d / 2};
BooleanDifference(200) = { Volume{rock[1]}; Delete; }{ Volume{100}; Delete; };

e = 1e-3;
Physical Volume("rock") = {200};
hole[] = Surface In BoundingBox{-d - e, -d - e, -deep - e, d + e, d + e, H - top + e};
Physical Surface("hole") = {hole[]};
Physical Surface("face") = Surface In BoundingBox{burden - e, -spacing, -e, burden + e, spacing, H + e};
Physical Surface("bench") = Surface In BoundingBox{-L - e, -spacing, H - e, burden + e, spacing, H + e};
Physical Surface("between_holes") = {
  Surface In BoundingBox{-L - e, -spacing / 2 - e, -L - e, L + e, -spacing / 2 + e, H + e},
  Surface In BoundingBox{-L - e, spacing / 2 - e, -L - e, L + e, spacing / 2 + e, H + e}
};
Physical Surface("outer") = {
  Surface In BoundingBox{-L - e, -spacing, -L - e, -L + e, spacing, H + e},
  Surface In BoundingBox{L - e, -spacing, -L - e, L + e, spacing, e},
  Surface In BoundingBox{-L - e, -spacing, -L - e, L + e, spacing, -L + e}
};

// Grows by 0.3 per distance from the hole.
Field[1] = MathEval;
Field[1].F = Sprintf("%g + 0.3*(Sqrt(x*x + y*y) - %g) + 0.15*(Abs(Abs(z - %g) - %g) + Abs(z - %g) - %g)",
  wall, d / 2, (H - top - deep) / 2, (H - top + deep) / 2, (H - top - deep) / 2, (H - top + deep) / 2);
Field[3] = Box;
Field[3].XMin = -1.5; Field[3].XMax = burden;
Field[3].YMin = -spacing; Field[3].YMax = spacing;
Field[3].ZMin = -1; Field[3].ZMax = H;
Field[3].VIn = h; Field[3].VOut = far;
Field[3].Thickness = 8;
Field[4] = Min;
Field[4].FieldsList = {1, 3};
Background Field = 4;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.Algorithm = 6;
Mesh.Optimize = 1;
Mesh.OptimizeNetgen = 1;
