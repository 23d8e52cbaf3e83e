// Plate with an edge notch that rises by `angle` degrees, pulled along y; lengths in metres.
DefineConstant[
  h = 0.15           // element size
  angle = 30         // of the notch, in degrees
  algorithm = 6      // 5: Delaunay; 6: frontal, rows of nearly equilateral triangles
];
W = 1; H = 1; a = 0.4; t = angle*Pi/180;
Point(1) = {0, 0.001, 0, h}; Point(2) = {a*Cos(t), a*Sin(t), 0, h}; Point(3) = {0, -0.001, 0, h};
Point(4) = {0, -H, 0, h}; Point(5) = {W, -H, 0, h}; Point(6) = {W, H, 0, h}; Point(7) = {0, H, 0, h};
Line(1) = {1,2}; Line(2) = {2,3}; Line(3) = {3,4}; Line(4) = {4,5}; Line(5) = {5,6}; Line(6) = {6,7}; Line(7) = {7,1};
Curve Loop(1) = {1:7}; Plane Surface(1) = {1};
Physical Surface("body") = {1}; Physical Curve("bottom") = {4}; Physical Curve("top") = {6};
Mesh.Algorithm = algorithm;
