// Quarter of a plate of 400 x 400 mm with a hole of radius 10 mm that is filled: `core` is what is taken out. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.001          // element size at the hole
  algorithm = 6      // 5: Delaunay's triangles, 6: rows
];

a = 0.01; L = 0.2;
r = 1.1 * a;         // the crown: a tenth of the radius thick, the last 10 degrees before the y-axis
c = Cos(80 * Pi / 180); s = Sin(80 * Pi / 180);

Point(1) = {0, 0, 0, 2 * h};
Point(2) = {a, 0, 0, h};
Point(3) = {a * c, a * s, 0, h};
Point(4) = {0, a, 0, h};
Point(5) = {0, r, 0, h};
Point(6) = {r * c, r * s, 0, h};
Point(7) = {L, 0, 0, 20 * h};
Point(8) = {L, L, 0, 20 * h};
Point(9) = {0, L, 0, 20 * h};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 5};
Circle(4) = {5, 1, 6};
Line(5) = {6, 3};
Line(6) = {2, 7};
Line(7) = {7, 8};
Line(8) = {8, 9};
Line(9) = {9, 5};
Line(10) = {1, 2};
Line(11) = {4, 1};
Curve Loop(1) = {2, 3, 4, 5};
Curve Loop(2) = {6, 7, 8, 9, 4, 5, -1};
Curve Loop(3) = {10, 1, 2, 11};
For i In {1 : 3}
  Plane Surface(i) = {i};
EndFor

Physical Surface("plate") = {1, 2};
Physical Surface("crown") = {1};
Physical Surface("core") = {3};
Physical Curve("x_axis") = {6, 10};
Physical Curve("y_axis") = {3, 9, 11};
Physical Curve("outer") = {7, 8};
Physical Curve("wall") = {1, 2};
Physical Point("side") = {2};
Physical Point("top") = {4};

Mesh.Algorithm = algorithm;
Mesh.Optimize = 1;
