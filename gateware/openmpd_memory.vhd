-- The memories of an OpenMPD board, in place of the blocks of the FPGA's maker, which are not public.
library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;

entity PhaseRAM is
    port (
        data : in std_logic_vector(6 downto 0);
        rdaddress : in std_logic_vector(3 downto 0);
        rdclock : in std_logic;
        wraddress : in std_logic_vector(8 downto 0);
        wrclock : in std_logic;
        wren : in std_logic;
        q : out std_logic_vector(223 downto 0)
    );
end entity;

architecture plain of PhaseRAM is
    type words is array (0 to 511) of std_logic_vector(6 downto 0);
    signal memory : words := (others => "0000000");
begin
    process (wrclock) begin
        if rising_edge(wrclock) and wren = '1' then
            memory(to_integer(unsigned(wraddress))) <= data;
        end if;
    end process;
    process (rdclock) begin
        if rising_edge(rdclock) then
            for place in 0 to 31 loop
                q(7 * place + 6 downto 7 * place) <= memory(32 * to_integer(unsigned(rdaddress)) + place);
            end loop;
        end if;
    end process;
end architecture;

library ieee;
use ieee.std_logic_1164.all;

entity AmplitudeRAM is
    port (
        data : in std_logic_vector(6 downto 0);
        rdaddress : in std_logic_vector(3 downto 0);
        rdclock : in std_logic;
        wraddress : in std_logic_vector(8 downto 0);
        wrclock : in std_logic;
        wren : in std_logic;
        q : out std_logic_vector(223 downto 0)
    );
end entity;

architecture plain of AmplitudeRAM is
begin
    memory : entity work.PhaseRAM port map (data, rdaddress, rdclock, wraddress, wrclock, wren, q);
end architecture;
