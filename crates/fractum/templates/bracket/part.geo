// An L-shaped bracket of two legs of 60 mm, 12 mm thick and 20 mm wide, in mm: gmsh part.geo -3
SetFactory("OpenCASCADE");
h = 3;                                    // size of elements
Box(1) = {0, 0, 0, 12, 60, 20};           // standing leg
Box(2) = {12, 0, 0, 48, 12, 20};          // lying leg
BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("bracket") = {3};
Physical Surface("top") = Surface In BoundingBox {-1, 59, -1, 13, 61, 21};
Physical Surface("end") = Surface In BoundingBox {59, -1, -1, 61, 13, 21};
Mesh.MeshSizeMax = h; Mesh.MeshSizeMin = h;
