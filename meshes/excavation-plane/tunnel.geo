// Half of a circular tunnel of radius 5 m in a square of rock of 200 x 200 m, in three parts: heading, bench, invert. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  h = 0.35           // element size at the wall
];

a = 5; L = 100; low = -a / 2; c = Sqrt(a * a - low * low);

Point(1) = {0, 0, 0, 2 * h};
Point(2) = {0, a, 0, h};
Point(3) = {a, 0, 0, h};
Point(4) = {c, low, 0, h};
Point(5) = {0, -a, 0, h};
Point(6) = {0, low, 0, 2 * h};
Point(7) = {0, L, 0, 25 * h};
Point(8) = {L, L, 0, 25 * h};
Point(9) = {L, 0, 0, 25 * h};
Point(10) = {L, -L, 0, 25 * h};
Point(11) = {0, -L, 0, 25 * h};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {4, 1, 5};
Line(4) = {1, 3};
Line(5) = {6, 4};
Line(6) = {2, 1};
Line(7) = {1, 6};
Line(8) = {6, 5};
Line(9) = {5, 11};
Line(10) = {11, 10};
Line(11) = {10, 9};
Line(12) = {9, 8};
Line(13) = {8, 7};
Line(14) = {7, 2};
Curve Loop(1) = {6, 4, -1};
Curve Loop(2) = {7, 5, -2, -4};
Curve Loop(3) = {8, -3, -5};
Curve Loop(4) = {1, 2, 3, 9, 10, 11, 12, 13, 14};
For i In {1 : 4}
  Plane Surface(i) = {i};
EndFor

Physical Surface("heading") = {1};
Physical Surface("bench") = {2};
Physical Surface("invert") = {3};
Physical Surface("rock") = {4};
Physical Curve("axis") = {6, 7, 8, 9, 14};
Physical Curve("outer") = {10, 11, 12, 13};
Physical Curve("wall") = {1, 2, 3};
Physical Curve("heading_wall") = {1};
Physical Curve("bench_floor") = {5};
Physical Point("crown") = {2};
Physical Point("side") = {3};
Physical Point("floor") = {5};
Physical Point("far") = {9};

Mesh.Algorithm = 5;
Mesh.Optimize = 1;
