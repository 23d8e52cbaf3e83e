// Section of the upper half of a hollow sphere about the y axis: radii inner and outer. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  inner = 0.05       // inner radius
  outer = 0.1        // outer radius
  h = 0.004          // element size
];

Point(1) = {0, 0, 0, h};
Point(2) = {inner, 0, 0, h};
Point(3) = {outer, 0, 0, h};
Point(4) = {0, outer, 0, h};
Point(5) = {0, inner, 0, h};
Line(1) = {2, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 5};
Circle(4) = {5, 1, 2};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};

Physical Surface("shell") = {1};
Physical Curve("equator") = {1};
Physical Curve("outer") = {2};
Physical Curve("inner") = {4};

Mesh.Algorithm = 5;
Mesh.Optimize = 1;
