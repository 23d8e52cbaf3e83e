// A row of vertical blast holes behind the face of a bench: the slice from the plane through a hole to the plane midway to the next one.
// The hole is square, charged below its stemming. Lengths in metres.
SetFactory("OpenCASCADE");

DefineConstant[
  burden = 1.25,     // from the hole to the face
  spacing = 2.5,     // from hole to hole
  h = 0.1,           // element size around hole and burden
  far = 0.7
];

d = 0.08; H = 3; top = 0.75; deep = 0.25; L = 5;
Point(1) = {-L, -L / 2, 0};
Point(2) = {L, -L / 2, 0};
Point(3) = {L, 0, 0};
Point(4) = {burden, 0, 0};
Point(5) = {burden, H, 0};
Point(6) = {-L, H, 0};
For i In {1:6}
  Line(i) = {i, i % 6 + 1};
EndFor
Curve Loop(1) = {1:6};
Plane Surface(1) = {1};
Extrude {0, 0, spacing / 2} { Surface{1}; }
Box(2) = {-d / 2, -deep, -d / 2, d, H - top + deep, d};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };

e = 1e-4;
Physical Volume("rock") = {3};
Physical Surface("hole") = Surface In BoundingBox {-d / 2 - e, -deep - e, -e, d / 2 + e, H - top + e, d / 2 + e};
Physical Surface("middle") = Surface In BoundingBox {-L - e, -L / 2 - e, -e, L + e, H + e, e};
Physical Surface("between") = Surface In BoundingBox {-L - e, -L / 2 - e, spacing / 2 - e, L + e, H + e, spacing / 2 + e};
Physical Surface("face") = Surface In BoundingBox {burden - e, -e, -e, burden + e, H + e, spacing / 2 + e};
Physical Surface("bench") = Surface In BoundingBox {-L - e, H - e, -e, burden + e, H + e, spacing / 2 + e};
back() = Surface In BoundingBox {-L - e, -L / 2 - e, -e, -L + e, H + e, spacing / 2 + e};
front() = Surface In BoundingBox {L - e, -L / 2 - e, -e, L + e, e, spacing / 2 + e};
bottom() = Surface In BoundingBox {-L - e, -L / 2 - e, -e, L + e, -L / 2 + e, spacing / 2 + e};
Physical Surface("outer") = {back(), front(), bottom()};

Field[1] = Box;
Field[1].XMin = -0.6; Field[1].XMax = burden;
Field[1].YMin = -0.4; Field[1].YMax = H;
Field[1].ZMin = 0; Field[1].ZMax = spacing / 2;
Field[1].VIn = h; Field[1].VOut = far;
Field[1].Thickness = 3;
Background Field = 1;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromCurvature = 0;
