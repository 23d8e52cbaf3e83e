// Bar 6 x 2 x 2 mm along x in three equal parts, for a bonded middle between two solid ends. The parts share their
// facets at x = 2 and 4 mm.
SetFactory("OpenCASCADE");

DefineConstant[
  h = 0.0005         // element size
];

w = 0.002;
Box(1) = {0, 0, 0, w, w, w};
Box(2) = {w, 0, 0, w, w, w};
Box(3) = {2*w, 0, 0, w, w, w};
Coherence;
e = 1e-6;
left() = Surface In BoundingBox {-e, -e, -e, e, w + e, w + e};
right() = Surface In BoundingBox {3*w - e, -e, -e, 3*w + e, w + e, w + e};
y_min() = Surface In BoundingBox {-e, -e, -e, 3*w + e, e, w + e};
z_min() = Surface In BoundingBox {-e, -e, -e, 3*w + e, w + e, e};

Physical Volume("bar") = {1, 2, 3};
Physical Volume("first") = {1};
Physical Volume("core") = {2};
Physical Volume("last") = {3};
Physical Surface("left") = {left()};
Physical Surface("right") = {right()};
Physical Surface("y_min") = {y_min()};
Physical Surface("z_min") = {z_min()};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
Mesh.Algorithm = 6;
Mesh.Algorithm3D = 1;
Mesh.Optimize = 1;
