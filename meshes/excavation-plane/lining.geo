// Quarter of a circular tunnel of radius 5 m in rock of 100 x 100 m, with the ring that becomes its lining. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.17           // element size in the lining
];

a = 5; t = 0.5; b = a - t; L = 100;
c = Cos(5 * Pi / 180); s = Sin(5 * Pi / 180);

Point(1) = {0, 0, 0, 6 * h};
Point(2) = {b, 0, 0, h};
Point(3) = {a, 0, 0, h};
Point(4) = {a * c, a * s, 0, h};
Point(5) = {b * c, b * s, 0, h};
Point(6) = {0, a, 0, h};
Point(7) = {0, b, 0, h};
Point(8) = {L, 0, 0, 60 * h};
Point(9) = {L, L, 0, 60 * h};
Point(10) = {0, L, 0, 60 * h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Circle(3) = {3, 1, 4};
Line(4) = {4, 5};
Circle(5) = {5, 1, 2};
Circle(6) = {4, 1, 6};
Line(7) = {6, 7};
Circle(8) = {7, 1, 5};
Line(9) = {7, 1};
Line(10) = {3, 8};
Line(11) = {8, 9};
Line(12) = {9, 10};
Line(13) = {10, 6};
Curve Loop(1) = {1, -5, -8, 9};
Curve Loop(2) = {2, 3, 4, 5};
Curve Loop(3) = {6, 7, 8, -4};
Curve Loop(4) = {10, 11, 12, 13, -6, -3};
For i In {1 : 4}
  Plane Surface(i) = {i};
EndFor

Physical Surface("core") = {1};
Physical Surface("ring") = {2, 3};
Physical Surface("section") = {2};
Physical Surface("rock") = {4};
Physical Curve("x_axis") = {1, 2, 10};
Physical Curve("y_axis") = {7, 9, 13};
Physical Curve("outer") = {11, 12};
Physical Point("side") = {3};
Physical Point("top") = {6};

Mesh.Algorithm = 5;
Mesh.Optimize = 1;
