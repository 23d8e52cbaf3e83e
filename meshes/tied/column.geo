// Column 9 x 1 x 1 mm along x for waves: solid up to x = 6 mm, bonded beyond. The plane x = 3 mm is the station where the
// pulse passes, and what is reflected passes again.
SetFactory("OpenCASCADE");

DefineConstant[
  h = 0.0001         // element size
];

w = 0.001;
Box(1) = {0, 0, 0, 3*w, w, w};
Box(2) = {3*w, 0, 0, 3*w, w, w};
Box(3) = {6*w, 0, 0, 3*w, w, w};
Coherence;
e = 1e-6;
driven() = Surface In BoundingBox {-e, -e, -e, e, w + e, w + e};
station() = Surface In BoundingBox {3*w - e, -e, -e, 3*w + e, w + e, w + e};
y_min() = Surface In BoundingBox {-e, -e, -e, 9*w + e, e, w + e};
y_max() = Surface In BoundingBox {-e, w - e, -e, 9*w + e, w + e, w + e};
z_min() = Surface In BoundingBox {-e, -e, -e, 9*w + e, w + e, e};
z_max() = Surface In BoundingBox {-e, -e, w - e, 9*w + e, w + e, w + e};

Physical Volume("column") = {1, 2, 3};
Physical Volume("core") = {3};
Physical Surface("driven") = {driven()};
Physical Surface("station") = {station()};
Physical Surface("y_faces") = {y_min(), y_max()};
Physical Surface("z_faces") = {z_min(), z_max()};
Physical Surface("sides") = {y_min(), y_max(), z_min(), z_max()};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
Mesh.Algorithm = 6;
Mesh.Algorithm3D = 1;
Mesh.Optimize = 1;
