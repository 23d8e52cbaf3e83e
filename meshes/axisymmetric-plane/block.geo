// Section of a round block about the y axis, with its top at y = 0; fine within a radius around the middle of the top. Lengths in metres.
SetFactory("Built-in");

DefineConstant[
  R = 0.06           // radius of the block
  H = 0.06           // height
  h = 0.00004        // element size near the middle of the top
  fine = 0.0008      // radius of the fine part
  far = 0.006        // element size far away
];

Point(1) = {0, -H, 0, far};
Point(2) = {R, -H, 0, far};
Point(3) = {R, 0, 0, far};
Point(4) = {0, 0, 0, far};
For k In {1:3}
  Line(k) = {k, k + 1};
EndFor
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};

Physical Surface("block") = {1};
Physical Curve("bottom") = {1};
Physical Curve("side") = {2};
Physical Curve("top") = {3};

Field[1] = MathEval;
Field[1].F = Sprintf("Min(%g, %g + 0.25*Max(0, Sqrt(x*x + y*y) - %g))", far, h, fine);
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 5;
Mesh.Optimize = 1;
