// A slab of 200 x 200 x 30 mm, in mm: gmsh part.geo -3
SetFactory("OpenCASCADE");
Box(1) = {-100, -100, 0, 200, 200, 30};
Physical Volume("slab") = {1};
Physical Surface("rim") = {1, 2, 3, 4};
Mesh.MeshSizeMax = 9; Mesh.MeshSizeMin = 9;
