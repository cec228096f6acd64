% Repeats the points of golden_dev.csv and golden_edge.csv (made by make_golden.m in the working folder) with the two other programs:
% appC_literal.m, the print's statements in their order, and belt_closed.m, closed forms without a loop.
% Prints the largest difference relative to max(|value|, 1e-3) of each program, and fails above 1e-9.
1;
addpath(fileparts(mfilename('fullpath')));
function d = far(a,b)
  d=max(abs(a-b)./max(abs(b),1e-3));
end
literal=0; closed=0; nl=0; nc=0;
for name={'golden_dev.csv','golden_edge.csv'}
  fid=fopen(name{1}); fgetl(fid);
  while ischar(line=fgetl(fid))
    c=strsplit(line,','); mode=c{2}; v=cellfun(@str2double,c(3:end));
    I=v(1); n=v(2); p=v(3); T=v(4); status=v(end);
    if status~=0, continue; end % the printed loop has no end, or its slip no meaning
    o=belt_defaults(mode); o.theta=v(5)*pi/180; o.drad=v(7)*1e-3; o.mu_band=v(8); o.nband=v(10); o.pri_endstop=v(11);
    r=belt_loss(I,n,p,T,struct('mode',mode,'theta',o.theta,'drad',o.drad,'mu_band',o.mu_band,'nband',o.nband,'pri_endstop',o.pri_endstop,'tol',1e-11));
    q=belt_closed(I,n,p,T,o);
    want=[r.rpri r.rsec r.betap r.betas r.lstrut r.Qpri r.deltaT r.Cx_raw r.Cx r.k r.vslip_gap r.vslip_idle r.vslip_pri r.vslip_sec r.slip_pct ...
      r.Tband_pri r.Tband_sec r.Tslip_pri r.Tslip_sec r.Twedge r.Tpen r.Ttotal r.dx1 r.dx2];
    got=q([1:9 11:end]); % the 10th is the number of segments before it is rounded up
    closed=max(closed,far(got,want)); nc++;
    if mode=='A' && v(11)==0 && v(7)==3
      q=appC_literal(I,n,p*1e5,T,1e-13,1e-9);
      want=[r.rpri r.rsec r.betap r.betas r.lstrut r.Qpri r.T1 r.T2 r.deltaT r.Cx r.k r.dx1 r.dx2 r.Tband_pri r.Tband_sec ...
        r.vslip_pri r.vslip_sec r.Tslip_pri r.Tslip_sec r.Twedge r.Tpen r.Ttotal];
      literal=max(literal,far(q,want)); nl++;
    end
  end
  fclose(fid);
end
printf('literal %d rows, largest relative difference %.1e\n',nl,literal);
printf('closed forms %d rows, largest relative difference %.1e\n',nc,closed);
if ~(literal<1e-9 && closed<1e-9), exit(1); end
