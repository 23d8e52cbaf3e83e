// L-shaped panel, 500 x 500 mm, legs of 250 mm (Winkler 2001): held below, lifted 30 mm from the end of its arm. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.01           // element size where the crack goes
  far = 0.035        // element size elsewhere
  algorithm = 5      // 5: Delaunay; 6: frontal, rows of nearly equilateral triangles
];

A = 0.5; B = 0.25; e = 0.03;

Point(1) = {0, 0, 0, far};
Point(2) = {B, 0, 0, far};
Point(3) = {B, B, 0, h};
Point(4) = {A - e, B, 0, far};
Point(5) = {A, B, 0, far};
Point(6) = {A, A, 0, far};
Point(7) = {0, A, 0, far};
For k In {1:6}
  Line(k) = {k, k + 1};
EndFor
Line(7) = {7, 1};
Curve Loop(1) = {1:7};
Plane Surface(1) = {1};

Physical Surface("panel") = {1};
Physical Curve("base") = {1};
Physical Point("load") = {4};

Field[1] = Box;
Field[1].VIn = h; Field[1].VOut = far;
Field[1].XMin = 0; Field[1].XMax = 0.27; Field[1].YMin = 0.22; Field[1].YMax = 0.36; Field[1].Thickness = 0.15;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = algorithm;
Mesh.Optimize = 1;
