import sys, collections, math
def read(p):
    d={}
    for l in open(p):
        f=l.strip().split("|")
        if len(f)>=11: d[f[0],f[1]]=(float(f[3]),float(f[4]),float(f[5]),float(f[6]),float(f[7]),float(f[8]),f[9])
    return d
a,b=read(sys.argv[1]),read(sys.argv[2]); verbose=len(sys.argv)>3
g=collections.OrderedDict()
for k in a:
    if k in b: g.setdefault(k[0],[]).append(k)
print(f"{'group':9} n  level(mean/low/high)      lowest mean  ms before after factor | uneven>1e-3 b,a")
for name,ks in g.items():
    pic=name=="pictures"
    r=[ (a[k][4]/max(b[k][4],1e-9)) if pic else (b[k][0]/a[k][0] if name.startswith("boards") else b[k][1]/a[k][1]) for k in ks]
    lo=[b[k][0]/a[k][0] for k in ks]
    ta=sum(a[k][5] for k in ks)/len(ks); tb=sum(b[k][5] for k in ks)/len(ks)
    print(f"{name:9} {len(ks):2} {sum(r)/len(r):.4f}/{min(r):.4f}/{max(r):.4f}  low {sum(lo)/len(lo):.4f}  {ta:9.3f} {tb:9.3f} x{tb/ta:.2f} | {sum(a[k][2]>1.2e-3 for k in ks)},{sum(b[k][2]>1.2e-3 for k in ks)}")
    if verbose and (sys.argv[3]=="all" or name in sys.argv[3].split(",")):
        for k,x in zip(ks,r): print(f"     {k[1]:28} {x:.4f}  {a[k][1]:.4f} ({a[k][2]:.0e}, leak {a[k][3]:.0e}, err {a[k][4]:.3f}, {a[k][5]:.2f} ms) -> {b[k][1]:.4f} ({b[k][2]:.0e}, {b[k][3]:.0e}, {b[k][4]:.3f}, {b[k][5]:.2f}) {a[k][6]} {b[k][6]}")
