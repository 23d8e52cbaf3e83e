// Right half of a plate with a slit across its middle, pulled along y; sizes over the process zone of 1/3 m. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.1            // element size along the line ahead of the slit, over the process zone
  slit = 2           // half length of the slit, over the process zone; the plate is three times as wide and as high
  algorithm = 5      // 5: Delaunay; 6: frontal, rows of nearly equilateral triangles
  line = 0           // 1: the line ahead of the slit is one of edges
];

zone = 1/3;
a = slit*zone; W = 3*a; s = h*zone; far = 0.15*W;

// The slit opens by a thousandth of its length.
Point(1) = {0, a/1000, 0, far};
Point(2) = {a, 0, 0, s};
Point(3) = {0, -a/1000, 0, far};
Point(4) = {0, -W, 0, far};
Point(5) = {W, -W, 0, far};
Point(6) = {W, W, 0, far};
Point(7) = {0, W, 0, far};
Point(8) = {W, 0, 0, s};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 8};
Line(6) = {8, 6};
Line(7) = {6, 7};
Line(8) = {7, 1};

If (line)
  Line(9) = {2, 8};
  Curve Loop(1) = {1, 9, 6, 7, 8};
  Curve Loop(2) = {2, 3, 4, 5, -9};
  Plane Surface(1) = {1};
  Plane Surface(2) = {2};
  Physical Surface("plate") = {1, 2};
  Physical Curve("line") = {9};
Else
  Curve Loop(1) = {1:8};
  Plane Surface(1) = {1};
  Physical Surface("plate") = {1};
EndIf
Physical Curve("left") = {3, 8};
Physical Curve("top") = {7};
Physical Curve("bottom") = {4};

Field[1] = Box;
Field[1].VIn = s; Field[1].VOut = far;
Field[1].XMin = a - 6*s; Field[1].XMax = 2*W; Field[1].YMin = -4*s; Field[1].YMax = 4*s; Field[1].Thickness = 3*far;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = algorithm;
Mesh.Optimize = 1;
